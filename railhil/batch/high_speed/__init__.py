"""Many high-speed trains at once: their motion compiled, their law on arrays; equal to the bench bit for bit."""
