"""What the artist sees: drawn from saved settings and the runtime figures, never computed here."""
