"""The parts that the studio's page is laid out of: the head, and the bars above the table and the scene."""
