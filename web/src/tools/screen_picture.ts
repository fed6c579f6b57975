/** Combines the map and its overlays to one picture. */
import type OlMap from 'ol/Map';

export async function screenPicture(map: OlMap, target: HTMLElement, background: string): Promise<Blob> {
  map.renderSync();
  const [width = 1, height = 1] = map.getSize() ?? [];
  const scale = window.devicePixelRatio;
  const canvas = document.createElement('canvas');
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const context = canvas.getContext('2d');
  if (!context) throw new Error('this browser gives no canvas to draw on');
  context.fillStyle = background;
  context.fillRect(0, 0, canvas.width, canvas.height);
  for (const layer of target.querySelectorAll<HTMLCanvasElement>('.ol-layer canvas')) {
    if (layer.width > 0) draw(context, layer, scale);
  }
  const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, 'image/png'));
  if (!blob) throw new Error('this browser makes no PNG of so large a picture');
  return blob;
}

/** OpenLayers keeps a layer's opacity and position in styles. */
function draw(context: CanvasRenderingContext2D, layer: HTMLCanvasElement, scale: number): void {
  const { opacity } = (layer.parentElement ?? layer).style;
  context.globalAlpha = opacity === '' ? 1 : Number(opacity);
  const place = new DOMMatrix(layer.style.transform);
  context.setTransform(new DOMMatrix().scale(scale).multiply(place));
  context.imageSmoothingEnabled = false;
  context.drawImage(layer, 0, 0);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.globalAlpha = 1;
}
