"""The panels below the table: a row explained, the pose of tool0, stored poses, measures, a description beside it."""
