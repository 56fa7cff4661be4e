"""The part that all estimators share, in the frame of the turning cabin."""
