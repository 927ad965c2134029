//! Some of a model's polygons.

use crate::io::read::Model;
use crate::mesh::PolygonSoup;

impl Model {
    /// Leaves out the polygons for which `keep` is false, with what belongs to them; vertices stay.
    /// [`MeshAttributes::kept`](crate::attributes::MeshAttributes::kept) then tells the numbers of the others. Linear time.
    ///
    /// # Panics
    /// If the ends of the soup are not ascending, which no reader makes.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let old = std::mem::take(&mut self.soup);
        let kept: Vec<usize> = (0..old.polygon_count()).filter(|&polygon| keep(polygon)).collect();
        let corners: Vec<usize> = kept.iter().flat_map(|&polygon| old.corner_range(polygon)).collect();
        let mut soup = PolygonSoup { positions: Vec::new(), ..PolygonSoup::default() };
        for &polygon in &kept {
            soup.push_polygon(old.polygon(polygon));
        }
        soup.positions = old.positions;
        self.soup = soup;
        self.attributes.select(&kept, &corners);
    }
}

#[cfg(test)]
mod tests {
    use crate::io::{Detail, read_model};

    #[test]
    fn what_belongs_to_a_polygon_stays_with_it() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 1 2\nvt 3 4\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/2 3/2 4/2\n\
                    usemtl c\nf 1 2 4\n";
        let mut model =
            read_model(text.as_bytes(), None, Detail::Attributes, &|_| Err(String::new())).unwrap();
        model.retain(|polygon| polygon != 0);
        assert_eq!((model.soup.polygon_count(), model.soup.polygon(0)), (2, &[0, 2, 3][..]));
        let names = |polygon| model.attributes.material_of.get(polygon);
        assert_eq!((names(0), names(1)), (Some(1), Some(2)));
        assert_eq!(model.attributes.uv[0].get(2), Some(glam::DVec2::new(3.0, 4.0)));
        assert_eq!(model.attributes.uv[0].get(3), None);
        assert_eq!(model.attributes.kept, Some(vec![1, 2]));
        model.retain(|polygon| polygon == 1);
        assert_eq!(model.attributes.kept, Some(vec![2]));
    }
}
