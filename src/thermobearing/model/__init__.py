"""A bearing becomes cells, layers and constants of the one coupled step."""
