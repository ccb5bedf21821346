//! What a wave does where a surface is not diffuse: vertex by vertex, as its BRDF asks.

use super::lanes;
use super::stage::Vertex;
use super::wave::Wave;

impl<'t> Wave<'t, '_> {
    /// Where lane k is.
    fn vertex(&self, k: usize) -> Option<Vertex<'t>> {
        let (facet, side) = self.place[k];
        let face = self.tracer.stage.face(facet as usize, side);
        let given = face.frame.to_local(-lanes::get(&self.arriving, k));
        let (facet, position) = (facet as usize, lanes::get(&self.position, k));
        Some(Vertex { facet, side, position, frame: &face.frame, reflection: face.reflection.as_ref()?, given })
    }

    /// Adds what an emitter sends that nothing hides: f E cosθ′ / p times the weight against finding it by a ray.
    pub(super) fn see_glossily(&mut self, k: usize, totals: usize) {
        let (stage, emitter) = (&self.tracer.stage, self.tracer.stage.emitters.get(self.emitter[k] as usize));
        let Some(vertex) = self.vertex(k) else { return };
        let point = lanes::get(&self.points.position, k);
        let offset = point - vertex.position;
        let distance_squared = offset.length_squared();
        let direction = offset / distance_squared.sqrt();
        let incident = vertex.frame.to_local(direction);
        let by_point = emitter.density * distance_squared / -direction.dot(emitter.normal);
        let by_ray = vertex.reflection.density(vertex.given, incident);
        let weight = self.tracer.sampling.weight(by_point, by_ray);
        let mut light: Vec<f64> =
            self.carried.iter().zip(emitter.emission).map(|(c, emission)| c[k] * emission).collect();
        vertex.reflection.scale(vertex.given, incident, incident.z / by_point * weight, &mut light);
        if light.iter().all(|light| *light <= 0.0) {
            return;
        }
        self.n_rays += 1;
        if !stage.tracer.occluded(vertex.position, point, [vertex.facet, emitter.facet]) {
            self.totals[totals..].iter_mut().zip(&light).for_each(|(total, light)| *total += light);
        }
    }

    /// Draws where the light of lane k may come from. What does not reflect is left to carry nothing.
    pub(super) fn turn_glossily(&mut self, k: usize) {
        let Some(vertex) = self.vertex(k) else { return };
        let uniform = [self.uniform[0][k], self.uniform[1][k]];
        let mut carried: Vec<f64> = self.carried.iter().map(|carried| carried[k]).collect();
        match vertex.reflection.turn(vertex.given, uniform, &mut carried) {
            Some(turn) => {
                lanes::set(&mut self.direction, k, vertex.frame.to_world(turn.direction));
                self.density[k] = turn.density;
            }
            None => carried.fill(0.0),
        }
        self.carried.iter_mut().zip(carried).for_each(|(all, carried)| all[k] = carried);
    }
}
