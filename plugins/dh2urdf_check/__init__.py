"""What the readers of robot descriptions do with a file: rules, and what each reader does with each fault."""
