"""The panels below the table: a row explained, and the pose of tool0."""
