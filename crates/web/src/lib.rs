//! The page and the JavaScript API of ldwrap.
