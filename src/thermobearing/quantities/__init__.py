"""The register of quantities, and tables that are described by it."""
