"""One file a command: arguments in, exit status out. Nothing heavy is imported before the arguments are good."""
