"""Parquet files: what their columns hold."""
