"""Events and values of programs as JSON has them."""
