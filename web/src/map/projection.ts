/** A plane in metres without a geographic position. */
import Projection from 'ol/proj/Projection';

export const kProjection = new Projection({ code: 'LOCAL', units: 'm' });
