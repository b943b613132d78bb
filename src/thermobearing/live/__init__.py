"""The live page: a bearing model that runs in the reader's browser."""
