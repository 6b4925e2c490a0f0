"""The parts that the studio's page is laid out of: the head, bars above and below the cells, and what takes files."""
