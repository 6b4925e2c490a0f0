"""The contract of edits, beside those of the other kinds of stages."""
