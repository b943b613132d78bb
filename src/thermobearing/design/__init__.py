"""What a designer needs: sizing, the design loop, temperature factors and bounds."""
