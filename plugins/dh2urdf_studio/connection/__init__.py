"""The way between pages and their server: who may use it, and that what a person does arrives though it breaks."""

ANSWERED = 60.0
"""How long a page may take to answer what it is asked [s], as on a slow network."""
