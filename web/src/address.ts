/** The chosen session and layer in the page's address, after '#': they survive a reload and can be shared as a link. */
import { isLayerName, type LayerName } from './layers/layers';

const kSession = 'session';
const kLayer = 'layer';

export function sessionOfHash(hash: string): string | null {
  return parametersOf(hash).get(kSession) || null;
}

/** Null when the address names none. */
export function layerOfHash(hash: string): LayerName | null {
  const layer = parametersOf(hash).get(kLayer);
  return isLayerName(layer) ? layer : null;
}

export function hashOfSession(name: string): string {
  return `#${new URLSearchParams({ [kSession]: name })}`;
}

/** Returns the same address with this layer in it; occupancy is the default and is left out. */
export function hashWithLayer(hash: string, layer: LayerName): string {
  const parameters = parametersOf(hash);
  if (layer === 'occupancy') parameters.delete(kLayer);
  else parameters.set(kLayer, layer);
  return `#${parameters}`;
}

function parametersOf(hash: string): URLSearchParams {
  return new URLSearchParams(hash.replace(/^#/, ''));
}
