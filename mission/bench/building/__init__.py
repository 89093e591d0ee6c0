"""The building benchmark: a mission in building.xml, its nine door faces beside the paper's Table 3."""
