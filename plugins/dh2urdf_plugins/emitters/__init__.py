"""Built-in emitters: one file each."""
