"""From measurements to wear coefficients, shear strengths and friction energy."""
