//! Tests of the whole project; each file beside this one is one kind of test.

#[cfg(test)]
mod assets;
