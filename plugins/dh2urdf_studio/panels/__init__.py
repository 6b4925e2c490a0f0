"""The panels below the table, such as a row explained and the pose of tool0, and what a click on a button does."""
