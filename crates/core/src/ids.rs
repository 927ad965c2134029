//! Indices with a type: a vertex cannot be mistaken for a face.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The id of the element at `index` of its array.
            ///
            /// # Panics
            /// If `index` does not fit in 32 bits; checked meshes are limited so that it does.
            #[inline]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("index fits in 32 bits"))
            }

            /// The place of the element in its array.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A vertex of a [`SurfaceMesh`](crate::SurfaceMesh).
    VertexId
);
id!(
    /// A triangle of a [`SurfaceMesh`](crate::SurfaceMesh).
    FaceId
);
id!(
    /// A side of a triangle, directed so that the triangle lies to its left: side `c` of face `f` is `3 f + c`.
    HalfedgeId
);
id!(
    /// A segment of the surface and, with the same number, its strip in the plane.
    StripId
);
id!(
    /// A polygon of the [`PolygonSoup`](crate::PolygonSoup) that a mesh was made from.
    PolygonId
);

impl HalfedgeId {
    /// The side of `face` from its corner `corner` (0, 1 or 2) to the next.
    #[inline]
    pub fn of(face: FaceId, corner: usize) -> Self {
        debug_assert!(corner < 3);
        Self(face.0 * 3 + corner as u32)
    }

    /// The triangle on the left.
    #[inline]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// The corner of its face at which it starts.
    #[inline]
    pub fn corner(self) -> usize {
        (self.0 % 3) as usize
    }

    /// The next side of the same face, counterclockwise.
    #[inline]
    pub fn next(self) -> Self {
        if self.0 % 3 == 2 { Self(self.0 - 2) } else { Self(self.0 + 1) }
    }

    /// The previous side of the same face.
    #[inline]
    pub fn previous(self) -> Self {
        if self.0.is_multiple_of(3) { Self(self.0 + 2) } else { Self(self.0 - 1) }
    }
}
