"""One module for each command that has much to say; cli.py puts them together."""
