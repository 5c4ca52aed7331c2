// odd layout
vec3
path_trace
(
  Ray ray
, inout uvec2 seed
)
{
  vec3
    samples
    [ 2 ] ; samples
      [ 0 ] = vec3 ( 1.0 ) ; samples [
    1 ] = vec3 ( 2.0 )
  ; for
  (
   int i = 0
   ; i < 2 ;
   ++ i ) samples [ i ] *= 0.5 ;
  return samples[0]+samples[1]*materials /* c */ [ 0 ] /* d */ . diffuse_albedo ;
}
