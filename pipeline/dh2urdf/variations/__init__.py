"""From one manipulator many: what is varied, by which laws, drawn by number."""
