"""Many runs of one program: varied values, disturbances, properties that hold or do not."""
