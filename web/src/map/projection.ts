/** Metres on a plane of the robots' own, tied to no place on Earth. */
import Projection from 'ol/proj/Projection';

export const kProjection = new Projection({ code: 'LOCAL', units: 'm' });
