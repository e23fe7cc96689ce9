"""The arm: from the nominal motion to target and actual joints, and what the joints carry."""
