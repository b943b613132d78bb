"""What a bearing is: geometry, materials, identified parameters, and the library of them."""
