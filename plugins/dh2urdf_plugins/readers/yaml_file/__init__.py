"""The form of YAML tables."""
