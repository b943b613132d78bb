"""What connects bodies besides bearings: hinges that yield, and devices."""
