"""What the scene shows of robots: shapes, frames, joint axes and parameters, as numbers for the page."""
