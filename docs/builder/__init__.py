"""What Sphinx needs of ours to build the site."""
