"""The buildings that ship: plans as data, written as MJCF that a person can edit."""
