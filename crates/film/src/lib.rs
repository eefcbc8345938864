//! The accumulated picture and the files it is written to.
