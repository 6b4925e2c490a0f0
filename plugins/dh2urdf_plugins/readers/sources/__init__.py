"""What tables come in: files and texts of many forms, each as rows of cells with their places."""
