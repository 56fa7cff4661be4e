"""What plugins share about bodies in contact: stone shapes, hulls, contact, coming to rest."""
