"""Built-in loaders: one file each."""
