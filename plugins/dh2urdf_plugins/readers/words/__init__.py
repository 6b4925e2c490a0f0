"""The words of tables: cells, names, fields and what may stand for them."""
