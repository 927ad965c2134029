//! Readers and writers: bytes in, bytes out, one file a format.
