"""The way between pages and their server: who may use it, and that what a person does arrives though it breaks."""
