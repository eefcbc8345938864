//! Point sets: readers, neighbours, local polynomials and the uniform grid.
