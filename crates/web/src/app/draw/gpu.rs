//! Draws pictures with OpenGL or WebGL2. The only file that talks to the graphics driver.
#![expect(unsafe_code, reason = "every call of the graphics driver is unsafe by its signature")]

use eframe::egui_glow::ShaderVersion;
use eframe::glow::{self, HasContext};
use glam::{Mat4, Vec3};

use super::shaders;
use super::{FaceData, Picture, PointVertex};

/// Triangles in one row of the texture that holds their colours.
const ROW: usize = 2048;

/// How a picture is drawn this time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    /// From the picture's space to clip space.
    pub(crate) matrix: Mat4,
    /// Where the eye is; points are lifted towards it.
    pub(crate) eye: Vec3,
    /// Where light comes from; `None` draws flat colours.
    pub(crate) light: Option<Vec3>,
    /// How far points are lifted, in units of the mesh.
    pub(crate) lift: f32,
    /// The triangle under the pointer.
    pub(crate) hover: Option<u32>,
    /// Sides of triangles are drawn.
    pub(crate) wireframe: bool,
    /// Cuts and borders are drawn.
    pub(crate) borders: bool,
    /// Points are drawn, this many pixels wide.
    pub(crate) points: Option<f32>,
    /// The colour of lines.
    pub(crate) ink: Vec3,
    /// The colour around points.
    pub(crate) rim: Vec3,
    /// Triangles may lie over each other in the plane: such places and the band are covered by these colours.
    pub(crate) covers: Option<Covers>,
    /// Pixels of the screen in one of egui's units.
    pub(crate) scale: f32,
}

/// Colours that are laid over parts of the plane, with their opacity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Covers {
    /// Over places that a strip covers more than once.
    pub(crate) overlap: [f32; 4],
    /// Over the band along the open border, where that is shown.
    pub(crate) band: Option<[f32; 4]>,
}

/// What the driver holds of one picture.
struct Held {
    version: [u64; 4],
    triangles: Buffer,
    faces: glow::Texture,
    points: Buffer,
    band: Buffer,
}

struct Buffer {
    array: glow::VertexArray,
    buffer: glow::Buffer,
    count: i32,
}

/// The programs, and what the driver holds of each picture.
pub(crate) struct Gpu {
    faces: glow::Program,
    points: glow::Program,
    held: Vec<Option<Held>>,
}

impl Gpu {
    /// Compiles the programs.
    ///
    /// # Errors
    /// When the driver does not know what they need.
    pub(crate) fn new(gl: &glow::Context) -> Result<Self, String> {
        let version = match ShaderVersion::get(gl) {
            ShaderVersion::Es300 => "#version 300 es\nprecision highp float;\nprecision highp int;\n",
            ShaderVersion::Gl140 => "#version 150\n",
            ShaderVersion::Gl120 | ShaderVersion::Es100 => {
                return Err("the graphics need OpenGL 3.2 or WebGL 2".into());
            }
        };
        let link = |sources| {
            // SAFETY: the context is current, as eframe promises while it creates the app.
            unsafe { program(gl, version, sources) }
        };
        Ok(Self { faces: link(shaders::FACES)?, points: link(shaders::POINTS)?, held: Vec::new() })
    }

    /// Draws a picture into the viewport and scissor box that are set. Each `place` keeps its data on the card.
    pub(crate) fn draw(&mut self, gl: &glow::Context, place: usize, picture: &Picture, shot: &Shot) {
        if self.held.len() <= place {
            self.held.resize_with(place + 1, || None);
        }
        // SAFETY: the context is current in a paint callback; all objects were made by it.
        unsafe {
            self.hold(gl, place, picture);
            if let Some(held) = &self.held[place] {
                self.shoot(gl, held, shot);
            }
        }
    }

    /// Sends what changed since the last time.
    unsafe fn hold(&mut self, gl: &glow::Context, place: usize, picture: &Picture) {
        unsafe {
            if self.held[place].is_none() {
                let (Some(triangles), Some(points), Some(band)) =
                    (self.buffer(gl, false), self.buffer(gl, true), self.buffer(gl, false))
                else {
                    return;
                };
                let Ok(faces) = gl.create_texture() else { return };
                self.held[place] = Some(Held { version: [u64::MAX; 4], triangles, faces, points, band });
            }
            let Some(held) = &mut self.held[place] else { return };
            let version = picture.version;
            if held.version[0] != version[0] {
                send(gl, &mut held.triangles, &picture.triangles);
            }
            if held.version[1] != version[1] {
                send_faces(gl, held.faces, &picture.faces);
            }
            if held.version[2] != version[2] {
                send(gl, &mut held.points, &picture.points);
            }
            if held.version[3] != version[3] {
                send(gl, &mut held.band, &picture.band);
            }
            held.version = version;
        }
    }

    unsafe fn buffer(&self, gl: &glow::Context, points: bool) -> Option<Buffer> {
        unsafe {
            let (array, buffer) = (gl.create_vertex_array().ok()?, gl.create_buffer().ok()?);
            gl.bind_vertex_array(Some(array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(buffer));
            let stride = if points { size_of::<PointVertex>() } else { size_of::<Vec3>() } as i32;
            gl.enable_vertex_attrib_array(0);
            gl.vertex_attrib_pointer_f32(0, 3, glow::FLOAT, false, stride, 0);
            if points {
                gl.enable_vertex_attrib_array(1);
                gl.vertex_attrib_pointer_f32(
                    1,
                    4,
                    glow::UNSIGNED_BYTE,
                    true,
                    stride,
                    size_of::<Vec3>() as i32,
                );
            }
            gl.bind_vertex_array(None);
            Some(Buffer { array, buffer, count: 0 })
        }
    }

    unsafe fn shoot(&self, gl: &glow::Context, held: &Held, shot: &Shot) {
        unsafe {
            gl.enable(glow::DEPTH_TEST);
            gl.depth_mask(true);
            gl.clear_depth_f32(1.0);
            gl.clear(glow::DEPTH_BUFFER_BIT);
            gl.depth_func(glow::LESS);
            self.shoot_faces(gl, held, shot);
            if let Some(size) = shot.points {
                gl.depth_func(glow::LEQUAL);
                gl.depth_mask(false);
                gl.use_program(Some(self.points));
                let at = |name| gl.get_uniform_location(self.points, name);
                gl.uniform_matrix_4_f32_slice(at("u_matrix").as_ref(), false, &shot.matrix.to_cols_array());
                gl.uniform_3_f32(at("u_eye").as_ref(), shot.eye.x, shot.eye.y, shot.eye.z);
                gl.uniform_1_f32(at("u_lift").as_ref(), shot.lift);
                gl.uniform_1_f32(at("u_size").as_ref(), size);
                gl.uniform_3_f32(at("u_rim").as_ref(), shot.rim.x, shot.rim.y, shot.rim.z);
                #[cfg(not(target_arch = "wasm32"))]
                gl.enable(glow::PROGRAM_POINT_SIZE);
                gl.bind_vertex_array(Some(held.points.array));
                gl.draw_arrays(glow::POINTS, 0, held.points.count);
            }
            gl.bind_vertex_array(None);
            gl.depth_mask(true);
            gl.depth_func(glow::LESS);
            gl.disable(glow::DEPTH_TEST);
        }
    }

    unsafe fn shoot_faces(&self, gl: &glow::Context, held: &Held, shot: &Shot) {
        unsafe {
            gl.use_program(Some(self.faces));
            let at = |name| gl.get_uniform_location(self.faces, name);
            let flag = |on: bool| if on { 1.0 } else { 0.0 };
            gl.active_texture(glow::TEXTURE0);
            gl.bind_texture(glow::TEXTURE_2D, Some(held.faces));
            gl.uniform_1_i32(at("u_faces").as_ref(), 0);
            gl.uniform_1_i32(at("u_row").as_ref(), ROW as i32);
            gl.uniform_1_i32(at("u_hover").as_ref(), shot.hover.map_or(-1, |f| f as i32));
            gl.uniform_matrix_4_f32_slice(at("u_matrix").as_ref(), false, &shot.matrix.to_cols_array());
            let light = shot.light.unwrap_or(Vec3::Z);
            gl.uniform_3_f32(at("u_light").as_ref(), light.x, light.y, light.z);
            gl.uniform_1_f32(at("u_shading").as_ref(), flag(shot.light.is_some()));
            gl.uniform_1_f32(at("u_wire").as_ref(), flag(shot.wireframe));
            gl.uniform_1_f32(at("u_borders").as_ref(), flag(shot.borders));
            gl.uniform_3_f32(at("u_ink").as_ref(), shot.ink.x, shot.ink.y, shot.ink.z);
            gl.uniform_1_f32(at("u_scale").as_ref(), shot.scale);
            let cover = |[r, g, b, a]: [f32; 4]| gl.uniform_4_f32(at("u_cover").as_ref(), r, g, b, a);
            cover([0.0; 4]);
            gl.bind_vertex_array(Some(held.triangles.array));
            gl.draw_arrays(glow::TRIANGLES, 0, held.triangles.count);
            if let Some(covers) = shot.covers {
                // Every triangle of the plane has a depth of its own, so what lies behind what was drawn is what
                // lies under another triangle.
                gl.depth_func(glow::GREATER);
                gl.depth_mask(false);
                cover(covers.overlap);
                gl.draw_arrays(glow::TRIANGLES, 0, held.triangles.count);
                // The band lies behind all triangles but before the empty plane: it passes only where a triangle
                // was drawn, and only once.
                if let Some(band) = covers.band {
                    gl.depth_mask(true);
                    cover(band);
                    gl.bind_vertex_array(Some(held.band.array));
                    gl.draw_arrays(glow::TRIANGLES, 0, held.band.count);
                }
            }
        }
    }

    /// Frees everything on the card.
    pub(crate) fn free(&mut self, gl: &glow::Context) {
        // SAFETY: the context is current when eframe ends the app; every object is deleted once.
        unsafe {
            gl.delete_program(self.faces);
            gl.delete_program(self.points);
            for held in self.held.drain(..).flatten() {
                gl.delete_texture(held.faces);
                for Buffer { array, buffer, .. } in [held.triangles, held.points, held.band] {
                    gl.delete_vertex_array(array);
                    gl.delete_buffer(buffer);
                }
            }
        }
    }
}

unsafe fn send<T: bytemuck::NoUninit>(gl: &glow::Context, to: &mut Buffer, vertices: &[T]) {
    unsafe {
        gl.bind_buffer(glow::ARRAY_BUFFER, Some(to.buffer));
        gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, bytemuck::cast_slice(vertices), glow::STATIC_DRAW);
        gl.bind_buffer(glow::ARRAY_BUFFER, None);
        to.count = i32::try_from(vertices.len()).unwrap_or(i32::MAX);
    }
}

unsafe fn send_faces(gl: &glow::Context, texture: glow::Texture, faces: &[FaceData]) {
    let rows = faces.len().div_ceil(ROW).max(1);
    let mut data = faces.to_vec();
    data.resize(rows * ROW, FaceData::default());
    unsafe {
        gl.bind_texture(glow::TEXTURE_2D, Some(texture));
        let nearest = glow::NEAREST as i32;
        gl.tex_parameter_i32(glow::TEXTURE_2D, glow::TEXTURE_MIN_FILTER, nearest);
        gl.tex_parameter_i32(glow::TEXTURE_2D, glow::TEXTURE_MAG_FILTER, nearest);
        gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
        gl.tex_image_2d(
            glow::TEXTURE_2D,
            0,
            glow::RGBA8UI as i32,
            ROW as i32,
            rows as i32,
            0,
            glow::RGBA_INTEGER,
            glow::UNSIGNED_BYTE,
            glow::PixelUnpackData::Slice(Some(bytemuck::cast_slice(&data))),
        );
        gl.bind_texture(glow::TEXTURE_2D, None);
    }
}

unsafe fn program(gl: &glow::Context, version: &str, sources: [&str; 2]) -> Result<glow::Program, String> {
    unsafe {
        let program = gl.create_program()?;
        let kinds = [glow::VERTEX_SHADER, glow::FRAGMENT_SHADER];
        for (kind, source) in kinds.into_iter().zip(sources) {
            let shader = gl.create_shader(kind)?;
            gl.shader_source(shader, &format!("{version}{source}"));
            gl.compile_shader(shader);
            if !gl.get_shader_compile_status(shader) {
                return Err(gl.get_shader_info_log(shader));
            }
            gl.attach_shader(program, shader);
            gl.delete_shader(shader);
        }
        gl.bind_attrib_location(program, 0, "a_position");
        gl.bind_attrib_location(program, 1, "a_colour");
        gl.link_program(program);
        if gl.get_program_link_status(program) { Ok(program) } else { Err(gl.get_program_info_log(program)) }
    }
}
