"""Readers of written files for the proof: they share nothing with what wrote them."""
