"""Attachment frames: where joints and loads act on bodies, one file for each kind."""
