/** The layers of a session, in the order of the keyboard shortcuts. */

export const kLayers = ['occupancy', 'sonar', 'himm', 'classification'] as const;

export type LayerName = (typeof kLayers)[number];

export const kLayerTitles: Record<LayerName, string> = {
  occupancy: 'Occupancy',
  classification: 'Classification',
  himm: 'HIMM',
  sonar: 'Sonar',
};

export const kLayerNotes: Record<LayerName, string> = {
  occupancy: 'Log-odds of all laser scans',
  classification: 'Free, occupied, frontier, danger',
  himm: 'Histogramic in-motion mapping: counters 0 to 15',
  sonar: 'Log-odds of all sonar readings',
};

export function isLayerName(text: string | null | undefined): text is LayerName {
  return kLayers.some((name) => name === text);
}

/** Returns the layer `steps` further on; the last is followed by the first. */
export function nextLayer(layer: LayerName, steps: number): LayerName {
  const count = kLayers.length;
  return kLayers[(kLayers.indexOf(layer) + steps + count) % count] ?? layer;
}

/** Returns a record with a value for each layer. */
export function forEachLayer<Value>(make: (layer: LayerName) => Value): Record<LayerName, Value> {
  return Object.fromEntries(kLayers.map((layer) => [layer, make(layer)])) as Record<LayerName, Value>;
}
