"""What a person sees: terminal tables and pictures. Arranges findings, computes none."""
